//! `--gap` and `--gap-for`.

mod check;
mod fix;
mod rules;

/// A square of two triangles, and one a bit higher in a second group whose corners hang over its inside.
fn sheets(height: f64) -> String {
    format!(
        "o floor\nv 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nf 1 2 3\nf 1 3 4\n\
         o lid\nv 1 1.1 {height}\nv 3 1 {height}\nv 3.1 3 {height}\nv 1 2.9 {height}\nf 5 6 7\nf 5 7 8\n"
    )
}
