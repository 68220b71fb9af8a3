//! Discs with any number of chains in one vertex.

use super::Sheet;

/// A disc folded sharply along its diameter `u = 0`, whose layers meet along `num_curves` curves from the centre
/// outwards.
///
/// The disc reaches less far where `u > 0`: each curve ends on the boundary there, and inside of the other layer.
pub fn fan(num_curves: u32, num_sectors: u32) -> Sheet {
    let mut sheet = Sheet::default();
    let place = |[u, v]: [f64; 2]| {
        // From one end of the crease to the other, the curves evenly between.
        let angle = v.atan2(u.abs()) + std::f64::consts::FRAC_PI_2;
        [u.abs(), v, 0.3 * u * (f64::from(num_curves) * angle).cos()]
    };
    let rings = 8u32;
    sheet.uvs.push([0.0; 2]);
    for ring in 1..=rings {
        for sector in 0..num_sectors {
            // No sector is the mirror image of another.
            let angle = std::f64::consts::TAU * (f64::from(sector) + 0.13) / f64::from(num_sectors);
            let reach = if angle.cos() > 0.0 { 0.4 } else { 0.5 };
            let radius = reach * f64::from(ring) / f64::from(rings);
            sheet.uvs.push([radius * angle.cos(), radius * angle.sin()]);
        }
    }
    sheet.positions = sheet.uvs.iter().copied().map(place).collect();
    let at = |ring: u32, sector: u32| 1 + (ring - 1) * num_sectors + sector % num_sectors;
    for sector in 0..num_sectors {
        sheet.faces.push([0, at(1, sector), at(1, sector + 1)]);
        for ring in 1..rings {
            sheet.faces.push([at(ring, sector), at(ring + 1, sector), at(ring + 1, sector + 1)]);
            sheet.faces.push([at(ring, sector), at(ring + 1, sector + 1), at(ring, sector + 1)]);
        }
    }
    sheet
}
