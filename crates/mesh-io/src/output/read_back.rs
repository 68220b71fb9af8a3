//! What a written file must give when it is read back.

use crate::{error::WriteError, mesh_file::MeshFile};

use super::Output;

impl Output<'_> {
    /// The positions that reading the written file gives, `num_vertices x 3`: those given, rounded to what the file
    /// holds. The rounding is that of the numbers in the file: singles, and in glTF singles in the coordinates of the
    /// node.
    ///
    /// # Errors
    /// As [`write`](Self::write), but for those of writing itself.
    pub fn stored_positions(&self, positions: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, WriteError> {
        self.check_length(positions)?;
        self.patched().map_or_else(|| Ok(positions.to_vec()), |file| file.stored_positions(positions))
    }

    /// Checks that the file that was written with `positions` and read back is what was meant: bit for bit the same
    /// positions, in the precision of the file, and the same polygons.
    ///
    /// # Errors
    /// [`WriteError::ReadBack`] with the first vertex or face that differs.
    pub fn check_read_back(&self, positions: &[[f64; 3]], read: &MeshFile) -> Result<(), WriteError> {
        let meant = self.stored_positions(positions)?;
        let differs = |what: String| Err(WriteError::ReadBack(what));
        if read.positions().len() != meant.len() {
            return differs(format!("{} vertices were written, {} are read", meant.len(), read.positions().len()));
        }
        let is_other = |(meant, read): (&[f64; 3], &[f64; 3])| meant.map(f64::to_bits) != read.map(f64::to_bits);
        if let Some(vertex) = meant.iter().zip(read.positions()).position(is_other) {
            let [meant, read] = [meant[vertex], read.positions()[vertex]].map(|[x, y, z]| format!("({x}, {y}, {z})"));
            return differs(format!("vertex {vertex} (from 0) was written at {meant}, and is read at {read}"));
        }
        let num_polygons: usize = self.files.iter().map(|file| file.polygons().len()).sum();
        if read.polygons().len() != num_polygons {
            return differs(format!("{num_polygons} faces were written, {} are read", read.polygons().len()));
        }
        let (mut first_vertex, mut first_polygon) = (0, 0);
        for file in self.files {
            let polygons = file.polygons();
            for polygon in 0..polygons.len() {
                let written = polygons.corners(polygon).iter().map(|&corner| first_vertex + corner as usize);
                let corners = read.polygons().corners(first_polygon + polygon).iter().map(|&corner| corner as usize);
                if !written.eq(corners) {
                    return differs(format!("face {} (from 0) has other corners", first_polygon + polygon));
                }
            }
            first_vertex += file.positions().len();
            first_polygon += polygons.len();
        }
        Ok(())
    }
}
