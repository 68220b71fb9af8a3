//! A polygon and the triangles it is split into.

/// One polygon.
#[derive(Clone, Copy, Debug)]
pub struct PolygonRef<'a> {
    /// Its corners, in order.
    pub corners: &'a [u32],
    /// Its triangles as the program at hand splits it.
    pub triangles: &'a [[u32; 3]],
    /// Whether it belongs to a body. Pairs of two such polygons are left out.
    pub is_body: bool,
}
