//! Global intersection analysis of one frame: intersections, paths, regions.

use crate::{
    frame::Frame,
    intersect::{Intersections, Intersector, SearchEnd, SearchLimits},
    mesh::Mesh,
    paths::{IntersectionPaths, PathFinder},
    regions::{InsideRegions, RegionFinder},
    settings::Settings,
    stage::{Stage, StageObserver},
};

/// What the global analysis of one frame found.
#[derive(Clone, Debug, Default)]
pub struct Analysis {
    /// Edge-face intersections and segments.
    pub intersections: Intersections,
    /// Paths, classified.
    pub paths: IntersectionPaths,
    /// Inside regions.
    pub regions: InsideRegions,
}

/// Analyses frames of one mesh, reusing its memory from frame to frame.
#[derive(Debug, Default)]
pub struct Analyser {
    intersector: Intersector,
    path_finder: PathFinder,
    region_finder: RegionFinder,
    analysis: Analysis,
    search: SearchEnd,
}

impl Analyser {
    /// Analyses one frame. The answer depends on the mesh, the frame and the settings alone.
    ///
    /// Where more intersects than the settings allow, or time is up before all of it is found, the analysis is empty;
    /// [`search_end`](Self::search_end) says so.
    ///
    /// Cost: O(n log n) in faces and segments together.
    pub fn analyse(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        settings: &Settings,
        observer: &mut dyn StageObserver,
    ) -> &Analysis {
        self.analyse_part(mesh, frame, settings, |_| (), observer)
    }

    /// As [`Analyser::analyse`], for what `select` leaves of the intersections: whole chains of segments.
    pub(crate) fn analyse_part(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        settings: &Settings,
        select: impl FnOnce(&mut Intersections),
        observer: &mut dyn StageObserver,
    ) -> &Analysis {
        let Analysis { intersections, paths, regions } = &mut self.analysis;
        observer.begin(Stage::Intersect);
        let limits = SearchLimits::new(settings, mesh.num_faces());
        self.search = self.intersector.intersect_within(mesh, frame, limits, observer, intersections);
        select(intersections);
        observer.begin(Stage::Paths);
        if !self.path_finder.find_within(mesh, frame, intersections, observer, paths) {
            self.search = SearchEnd::OutOfTime;
            intersections.clear();
        }
        observer.begin(Stage::Regions);
        self.region_finder.find(mesh, frame, paths, settings, observer, regions);
        observer.end();
        &self.analysis
    }

    /// Clears what is cached from frame to frame, so that the next search is a cold one: for measuring, since answers
    /// never depend on earlier frames.
    pub fn clear_cache(&mut self) {
        self.intersector.clear_cache();
    }

    /// How the search of the last frame ended.
    #[must_use]
    pub fn search_end(&self) -> SearchEnd {
        self.search
    }

    /// The last analysis, without a copy of it.
    #[must_use]
    pub fn into_last(self) -> Analysis {
        self.analysis
    }

    /// The last analysis.
    #[must_use]
    pub fn last(&self) -> &Analysis {
        &self.analysis
    }
}

/// Analyses one frame of one mesh with the default settings, whatever intersects; see [`Analyser`] for many frames.
#[must_use]
pub fn analyse(mesh: &Mesh, frame: &Frame) -> Analysis {
    let mut analyser = Analyser::default();
    let unlimited =
        Settings { max_face_pairs: Some(u64::MAX), max_tested_pairs: Some(u64::MAX), ..Settings::default() };
    analyser.analyse(mesh, frame, &unlimited, &mut ());
    analyser.into_last()
}
