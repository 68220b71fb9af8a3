//! `--gap` and `--gap-for`.

mod check;
mod fix;
mod ipctk;
mod rules;

/// A square of two triangles, and one a bit higher in a second group whose corners hang over its inside.
fn sheets(height: f64) -> String {
    format!(
        "o floor\nv 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nf 1 2 3\nf 1 3 4\n\
         o lid\nv 1 1.1 {height}\nv 3 1 {height}\nv 3.1 3 {height}\nv 1 2.9 {height}\nf 5 6 7\nf 5 7 8\n"
    )
}

/// Two grids of `cells x cells` squares, the upper one bent upwards from `height` above the flat lower one, and a bit
/// turned.
fn grids(cells: u32, height: f64) -> String {
    let mut text = String::new();
    for (index, name) in ["lower", "upper"].iter().enumerate() {
        text += &format!("o {name}\n");
        let turn = if index == 0 { 0.0_f64 } else { 0.1 };
        for row in 0..=cells {
            for column in 0..=cells {
                let [u, v] = [column, row].map(|step| f64::from(step) / f64::from(cells) - 0.5);
                let [x, y] = [u * turn.cos() - v * turn.sin(), u * turn.sin() + v * turn.cos()];
                let z = 0.1 * x - 0.05 * y + if index == 0 { 0.0 } else { height + 0.002 * x * x };
                text += &format!("v {x} {y} {z}\n");
            }
        }
        let first = 1 + u32::try_from(index).unwrap() * (cells + 1) * (cells + 1);
        for row in 0..cells {
            for column in 0..cells {
                let at = first + row * (cells + 1) + column;
                text += &format!(
                    "f {} {} {}\nf {} {} {}\n",
                    at,
                    at + 1,
                    at + cells + 2,
                    at,
                    at + cells + 2,
                    at + cells + 1
                );
            }
        }
    }
    text
}
