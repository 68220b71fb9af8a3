//! Values of a text layer, by the type of their property.

use super::lexer::{Lexer, Token, unescape};
use crate::usd::{fault::Fault, layers::value::Value};

/// Decodes the bytes of a value. Cost: that of its bytes.
pub(super) fn decode(bytes: &[u8], type_name: &str) -> Result<Value, Fault> {
    let lexer = &mut Lexer::new(bytes);
    if lexer.peek()? == Token::Word("None") {
        return Ok(Value::Blocked);
    }
    let (name, is_array) = type_name.strip_suffix("[]").map_or((type_name, false), |name| (name, true));
    Ok(match (name, is_array) {
        ("point3f" | "float3" | "normal3f" | "vector3f" | "color3f", true) => Value::Singles(vectors(lexer, 3)?),
        ("texCoord2f" | "float2", true) => Value::Singles(vectors(lexer, 2)?),
        ("int" | "uint", true) => {
            let mut values = Vec::new();
            list(lexer, |lexer| {
                values.push(number::<i64>(lexer)?);
                Ok(())
            })?;
            Value::Integers(values)
        }
        ("token" | "string", true) => {
            let mut texts = Vec::new();
            list(lexer, |lexer| {
                texts.push(text(lexer)?);
                Ok(())
            })?;
            Value::Texts(texts)
        }
        ("token" | "string" | "asset", false) => Value::Text(text(lexer)?),
        ("bool", false) => Value::Bool(matches!(lexer.next()?, Token::Word("true" | "True" | "1"))),
        (_, false) => Value::Numbers(numbers(lexer)?),
        _ => Value::Other,
    })
}

fn text(lexer: &mut Lexer<'_>) -> Result<String, Fault> {
    match lexer.next()? {
        Token::Quoted(text) => Ok(unescape(text).into_owned()),
        Token::Asset(text) => Ok(text.to_owned()),
        _ => Err(lexer.fault("text in quotes is needed here")),
    }
}

fn number<T: std::str::FromStr>(lexer: &mut Lexer<'_>) -> Result<T, Fault> {
    match lexer.next()? {
        Token::Word(word) => word.parse().map_err(|_| lexer.fault(format!("`{word}` is no number that fits here"))),
        _ => Err(lexer.fault("a number is needed here")),
    }
}

/// A coordinate, as USD reads it: to the nearest double, then to the nearest single.
fn single(lexer: &mut Lexer<'_>) -> Result<f32, Fault> {
    #[expect(clippy::cast_possible_truncation, reason = "rounding is the purpose")]
    Ok(number::<f64>(lexer)? as f32)
}

/// Elements between brackets.
fn list<'b>(lexer: &mut Lexer<'b>, mut element: impl FnMut(&mut Lexer<'b>) -> Result<(), Fault>) -> Result<(), Fault> {
    lexer.expect(b'[')?;
    while !lexer.take(b']') {
        element(lexer)?;
        if !lexer.take(b',') {
            return lexer.expect(b']');
        }
    }
    Ok(())
}

/// Vectors in an array, flat.
fn vectors(lexer: &mut Lexer<'_>, size: usize) -> Result<Vec<f32>, Fault> {
    let mut values = Vec::new();
    list(lexer, |lexer| {
        lexer.expect(b'(')?;
        for component in 0..size {
            if component > 0 {
                lexer.expect(b',')?;
            }
            values.push(single(lexer)?);
        }
        lexer.expect(b')')
    })?;
    Ok(values)
}

/// The components of a number, vector, quaternion or matrix, whatever its brackets.
fn numbers(lexer: &mut Lexer<'_>) -> Result<Vec<f64>, Fault> {
    let mut numbers = Vec::new();
    loop {
        match lexer.next()? {
            Token::Sign(_) => {}
            Token::Word(word) => numbers
                .push(word.parse().map_err(|_| lexer.fault(format!("`{word}` stands where a number is needed")))?),
            Token::End => return Ok(numbers),
            _ => return Err(lexer.fault("a number is needed here")),
        }
    }
}
