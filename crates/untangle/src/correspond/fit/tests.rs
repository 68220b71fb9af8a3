//! Thin-plate fits of difficult centres: on a line, on the flattest of arcs, in nearly one place, and a thousand of
//! them.

use nalgebra::Point2;

use super::ThinPlate;

/// A reflection that bends.
fn bent(p: Point2<f64>) -> Point2<f64> {
    Point2::new(-p.x + 0.2 * p.y * p.y, p.y + 0.1 * p.x * p.y)
}

/// Centres on a slanting arc of so many radians and length 2; on a line for 0.
fn arc(count: u32, angle: f64) -> Vec<Point2<f64>> {
    let place = |k: u32| {
        let along = 2.0 * f64::from(k) / f64::from(count - 1) - 1.0;
        let across = 0.25 * angle * along * along;
        Point2::new(0.96 * along - 0.28 * across, 0.28 * along + 0.96 * across)
    };
    (0..count).map(place).collect()
}

fn circle(count: u32, shift: f64) -> impl Iterator<Item = Point2<f64>> {
    let angle = move |k: u32| std::f64::consts::TAU * f64::from(k) / f64::from(count) + shift;
    (0..count).map(move |k| Point2::new(angle(k).cos(), angle(k).sin()))
}

/// Fits a map, and returns it, by how much the map misses its centres at worst, and the largest coordinate of an image
/// near them.
fn fitted(centres: &[Point2<f64>], values: &[Point2<f64>]) -> (ThinPlate, f64, f64) {
    let mut plate = ThinPlate::default();
    assert!(plate.fit(centres, values));
    assert!(plate.condition().is_finite() && plate.rank() <= centres.len() + 3);
    let misses = centres.iter().zip(values).map(|(&centre, value)| (plate.evaluate(centre) - value).norm());
    let miss = misses.fold(0.0, f64::max);
    let near = centres
        .iter()
        .flat_map(|&centre| [0.0, 0.1, 0.5].map(|part| centre + (Point2::new(0.3, -0.2) - centre) * part));
    let largest = near.map(|place| plate.evaluate(place).coords.amax()).fold(0.0, f64::max);
    assert!(miss.is_finite() && largest.is_finite());
    (plate, miss, largest)
}

#[test]
fn thin_plate_of_arc_of_any_flatness_interpolates_or_is_rank_deficient() {
    for count in [3, 4, 5, 30, 100, 300] {
        for angle in [1.0, 1e-2, 1e-4, 1e-6, 1e-9, 1e-12, 0.0] {
            let centres = arc(count, angle);
            let values: Vec<_> = centres.iter().copied().map(bent).collect();
            let (plate, miss, _) = fitted(&centres, &values);
            let is_short = plate.rank() < centres.len() + 3;
            assert!(miss < 1e-6, "{count} on {angle:e}: {miss:e}, short {is_short}");
            assert!(is_short || angle > 0.0, "{count} on a line: the slope across it is not known");
            // A bend along the arc leaves the slope across it undetermined; the image of a rotation must stay bounded
            // beside it.
            let turned: Vec<_> = centres.iter().map(|p| Point2::new(-p.y, p.x)).collect();
            let (_, miss, largest) = fitted(&centres, &turned);
            assert!(miss < 1e-6 && largest < 2.0, "{count} on {angle:e}: {miss:e} {largest:e}");
        }
    }
}

#[test]
fn thin_plate_of_nearly_coincident_centres_stays_finite() {
    for gap in [1e-3, 1e-6, 1e-9, 1e-12, 1e-15] {
        let centres: Vec<_> = circle(20, 0.0).chain(circle(20, gap)).collect();
        let values: Vec<_> = centres.iter().copied().map(bent).collect();
        let (_, miss, largest) = fitted(&centres, &values);
        assert!(miss < 1e-6 && largest < 3.0, "{gap:e}: {miss:e} {largest:e}");
    }
}

#[test]
fn thin_plate_of_coincident_contradicting_centres_stays_finite() {
    for gap in [1e-3, 1e-6, 1e-9, 0.0] {
        let centres: Vec<_> = circle(20, 0.0).chain(circle(20, gap)).collect();
        let values: Vec<_> = circle(20, 0.0).chain(circle(20, 0.5)).collect();
        fitted(&centres, &values);
    }
    fitted(&[Point2::new(2.0, 3.0); 7], &circle(7, 0.0).collect::<Vec<_>>());
}

#[test]
fn thin_plate_of_a_thousand_centres_interpolates() {
    let centres: Vec<_> = circle(1000, 0.0).collect();
    let values: Vec<_> = centres.iter().copied().map(bent).collect();
    let (plate, miss, largest) = fitted(&centres, &values);
    assert_eq!(plate.rank(), 1003);
    assert!(miss < 1e-9 && largest < 3.0, "{miss:e} {largest:e}");
}
