//! Metadata of a text layer that name other prims and layers.

use std::collections::BTreeMap;

use super::lexer::{Lexer, Token, unescape};
use crate::usd::{
    fault::Fault,
    layers::spec::{ArcTarget, ListOp},
};

/// One target, a list of them, or `None`.
pub(super) fn targets(lexer: &mut Lexer<'_>) -> Result<Vec<ArcTarget>, Fault> {
    let mut targets = Vec::new();
    if !lexer.take(b'[') {
        targets.extend(target(lexer)?);
        return Ok(targets);
    }
    let start = lexer.end();
    while !lexer.take_end(b']', start)? {
        targets.extend(target(lexer)?);
        lexer.take(b',');
    }
    Ok(targets)
}

/// `@layer@<prim> (offset = 1; scale = 2)`, parts of which may be missing.
fn target(lexer: &mut Lexer<'_>) -> Result<Option<ArcTarget>, Fault> {
    let mut target = ArcTarget::default();
    match lexer.next()? {
        Token::Word("None") => return Ok(None),
        Token::Asset(asset) => {
            asset.clone_into(&mut target.asset);
            if let Token::Path(path) = lexer.peek()? {
                lexer.next()?;
                path.clone_into(&mut target.prim);
            }
        }
        Token::Path(path) => path.clone_into(&mut target.prim),
        _ => return Err(lexer.fault("a layer or a prim is needed here")),
    }
    if lexer.take(b'(') {
        let start = lexer.end();
        while !lexer.take_end(b')', start)? {
            match lexer.next()? {
                Token::Word(name @ ("offset" | "scale")) if lexer.take(b'=') => {
                    let Token::Word(word) = lexer.next()? else { return Err(lexer.fault("a number is needed here")) };
                    let number = word.parse().map_err(|_| lexer.fault("a number is needed here"))?;
                    let retiming = &mut target.retiming;
                    *(if name == "offset" { &mut retiming.offset } else { &mut retiming.scale }) = number;
                }
                Token::Sign(b'=') => lexer.skip_value()?,
                _ => {}
            }
        }
    }
    Ok(Some(target))
}

/// Edits a list as its metadata say.
pub(super) fn edit(list: &mut ListOp<ArcTarget>, edit: Option<&str>, targets: Vec<ArcTarget>) {
    match edit {
        None => list.explicit = Some(targets),
        Some("prepend") => list.prepended = targets,
        Some("delete") => list.deleted = targets,
        Some("reorder") => {}
        Some(_) => list.appended.extend(targets),
    }
}

/// `{ string set = "variant" }`
pub(super) fn selections(lexer: &mut Lexer<'_>) -> Result<BTreeMap<String, String>, Fault> {
    let mut selections = BTreeMap::new();
    lexer.expect(b'{')?;
    let start = lexer.end();
    while !lexer.take_end(b'}', start)? {
        let mut set = String::new();
        loop {
            match lexer.next()? {
                Token::Word(word) => word.clone_into(&mut set),
                Token::Quoted(text) => set = unescape(text).into_owned(),
                Token::Sign(b'=') => break,
                _ => return Err(lexer.fault("the selection of a variant is needed here")),
            }
        }
        let Token::Quoted(variant) = lexer.next()? else { return Err(lexer.fault("a name in quotes is needed here")) };
        selections.insert(set, unescape(variant).into_owned());
        lexer.take(b';');
    }
    Ok(selections)
}

/// One name, or a list of them.
pub(super) fn names(lexer: &mut Lexer<'_>) -> Result<Vec<String>, Fault> {
    let mut names = Vec::new();
    let is_list = lexer.take(b'[');
    loop {
        match lexer.next()? {
            Token::Quoted(name) => names.push(unescape(name).into_owned()),
            Token::Sign(b',') if is_list => {}
            Token::Sign(b']') if is_list => return Ok(names),
            Token::Word("None") if !is_list => {}
            _ => return Err(lexer.fault("a name in quotes is needed here")),
        }
        if !is_list {
            return Ok(names);
        }
    }
}
