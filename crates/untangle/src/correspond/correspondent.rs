//! Finds the correspondences of all paths of a frame, step by step: charts, lifted paths, sides, fit, separation
//! constraints, attractions.

use super::{
    chart_pair::ChartPair,
    charts::ChartKind,
    correspondences::{Correspondences, PathCorrespondence},
    fit::PathFit,
    lifted::LiftedPair,
    path_input::{PathInput, is_partitioning},
    separations::SheetsAlongPath,
    shared_by_pair::{SharedCharts, SharedResults, add_exchanged, have_same_points},
    targets::{TargetMap, TargetScratch},
};
use crate::{
    analysis::Analysis, frame::Frame, mesh::Mesh, paths::Sheet, regions::starts_pair, settings::Settings,
    stage::StageObserver,
};

/// Finds correspondences, reusing its memory from frame to frame.
#[derive(Debug, Default)]
pub struct Correspondent {
    correspondences: Correspondences,
    charts: ChartPair,
    lifted: LiftedPair,
    fit: PathFit,
    /// What the first path of the present pair leaves to the second.
    shared: Option<SharedCharts>,
    targets: TargetScratch,
}

impl Correspondent {
    /// Finds the correspondence of every path whose region divides its piece. Paths without one, and paths for which no
    /// chart exists, are left out; so are the shortest ones, once the observer says that time is up.
    ///
    /// Cost: for each path linear in its faces, its region and as much of the other sheet; cubic in its centres.
    pub fn find(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        analysis: &Analysis,
        settings: &Settings,
        observer: &mut dyn StageObserver,
    ) -> &Correspondences {
        self.clear();
        let order = &analysis.regions.order[..analysis.regions.num_done];
        for (place, &copy) in order.iter().enumerate() {
            if starts_pair(&analysis.paths, order, place) && observer.is_spent() {
                break;
            }
            if is_partitioning(analysis, copy) {
                if let Some(input) = PathInput::new(mesh, frame, analysis, settings, copy) {
                    let found = self.correspond(&input);
                    self.correspondences.paths.extend(found);
                }
                self.lifted.undo_exchange();
            }
            self.correspondences.num_done = place + 1;
        }
        self.correspondences.paths.sort_unstable_by_key(|path| path.copy);
        &self.correspondences
    }

    /// Clears the correspondences of the last frame.
    pub(crate) fn clear(&mut self) -> &Correspondences {
        self.correspondences.paths.clear();
        self.correspondences.attractions.clear();
        self.correspondences.separations.clear();
        self.correspondences.num_done = 0;
        self.shared = None;
        &self.correspondences
    }

    /// The correspondences of the last frame.
    pub(crate) fn found(&self) -> &Correspondences {
        &self.correspondences
    }

    /// The correspondence of one path with a region; nothing where there is no chart, or the region lies on no side of
    /// the path.
    fn correspond(&mut self, input: &PathInput<'_>) -> Option<PathCorrespondence> {
        let partner = input.path.partner;
        let shared = self.shared.take().filter(|shared| [shared.copy, shared.partner] == [partner, input.copy]);
        self.charts.assign(shared.is_some(), input.has_one_chart());
        let [own_chart, partner_chart] = self.build_charts_and_lift(input, shared.as_ref())?;
        let results = shared.and_then(|shared| shared.results);
        let (side, known_image_side) = self.choose_sides(input, results.as_ref())?;
        let sheets = SheetsAlongPath::new(input, &self.charts);
        let sides = (side, known_image_side.unwrap_or_else(|| sheets.likelier_side(side)));
        let residual_m = self.fit.fit(&self.lifted, sides, input.edge_length_m, input.is_joint, input.settings)?;

        let first_attraction = self.correspondences.attractions.len();
        let first_separation = self.correspondences.separations.len();
        self.separate(input, sides, results);
        self.share_results(input, (side, known_image_side), first_separation);
        self.attract(input, sides);
        let PathFit { centres, plate } = &self.fit;
        Some(PathCorrespondence {
            copy: input.copy,
            own_chart,
            partner_chart,
            round: self.lifted.both_wind(),
            num_centres: centres.from.len(),
            rank_deficiency: centres.from.len() + 3 - plate.rank(),
            condition: plate.condition(),
            residual_m,
            edge_length_m: input.edge_length_m,
            attractions: first_attraction..self.correspondences.attractions.len(),
            separations: first_separation..self.correspondences.separations.len(),
        })
    }

    /// Makes the charts of path and corresponding path and lifts the path in both, as far as the first path of the pair
    /// has not done so. Returns how the charts were made; nothing where there is no chart, or a part of the path lies
    /// outside of it.
    fn build_charts_and_lift(
        &mut self,
        input: &PathInput<'_>,
        shared: Option<&SharedCharts>,
    ) -> Option<[ChartKind; 2]> {
        let PathInput { mesh, points, segments, .. } = *input;
        let own_chart = match shared {
            Some(shared) => shared.kinds[1],
            None => self.charts.build_own(input)?,
        };
        let is_lifted = shared.is_some_and(|shared| shared.results.is_some());
        if is_lifted {
            self.lifted.exchange();
        } else {
            if !self.lifted.lift_own(mesh, points, segments, input.path.closed, self.charts.own()) {
                return None;
            }
            self.charts.own_mut().set_period(self.lifted.own.period);
        }
        let partner_chart = match shared {
            _ if input.has_one_chart() => own_chart,
            Some(shared) => shared.kinds[0],
            // The chart reaches as far as the lifted path says.
            None => self.charts.build_partner(input, &self.lifted.own)?,
        };
        let kinds = [own_chart, partner_chart];
        if input.partner_region.is_some() && !input.has_one_chart() && shared.is_none() {
            self.shared = Some(SharedCharts { copy: input.copy, partner: input.path.partner, kinds, results: None });
        }
        if !is_lifted {
            if !self.lifted.lift_partner(mesh, points, segments, self.charts.partner()) {
                return None;
            }
            self.charts.partner_mut().set_period(self.lifted.partner.period);
        }
        Some(kinds)
    }

    /// The side of the path on which its region lies, and that of the corresponding path where a region says so.
    /// Nothing where the region lies on no side of the path.
    fn choose_sides(&mut self, input: &PathInput<'_>, results: Option<&SharedResults>) -> Option<(f64, Option<f64>)> {
        if let Some(SharedResults { sides: (partner_side, own_side), .. }) = results {
            return Some(((*own_side)?, Some(*partner_side)));
        }
        let PathInput { mesh, points, segments, region, partner_region, .. } = *input;
        let (own, partner) = (self.charts.own(), self.charts.partner());
        let side = self.lifted.region_side(mesh, points, segments, Sheet::Own, own, region)?;
        let image_side = partner_region
            .and_then(|region| self.lifted.region_side(mesh, points, segments, Sheet::Partner, partner, region));
        Some((side, image_side))
    }

    /// Adds the separation constraints of the path.
    fn separate(&mut self, input: &PathInput<'_>, sides: (f64, f64), results: Option<SharedResults>) {
        let separations = &mut self.correspondences.separations;
        match results {
            Some(results) => add_exchanged(separations, results.separations),
            None => SheetsAlongPath::new(input, &self.charts).separate(sides, input.share(), separations),
        }
    }

    /// Leaves the results of the first path of a pair to the second, where that one lists the same points.
    fn share_results(&mut self, input: &PathInput<'_>, sides: (f64, Option<f64>), first_separation: usize) {
        if let Some(shared) = &mut self.shared
            && have_same_points(&input.analysis.paths, [input.copy, input.path.partner])
        {
            let separations = first_separation..self.correspondences.separations.len();
            shared.results = Some(SharedResults { sides, separations });
        }
    }

    /// Adds the attractions of the points inside to their targets.
    fn attract(&mut self, input: &PathInput<'_>, sides: (f64, f64)) {
        let (own, partner) = (self.charts.own(), self.charts.partner());
        let map = TargetMap { own, partner, pair: &self.lifted, plate: &self.fit.plate, sides };
        map.attract(input, &mut self.targets, &mut self.correspondences.attractions);
    }
}
