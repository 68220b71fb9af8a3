//! Global intersection analysis of one frame: intersections, paths, regions.

use crate::{
    frame::Frame,
    intersect::{Intersections, Intersector},
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
}

impl Analyser {
    /// Analyses one frame. The answer depends on the mesh, the frame and the settings alone.
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
        self.intersector.intersect(mesh, frame, intersections);
        select(intersections);
        observer.begin(Stage::Paths);
        self.path_finder.find(mesh, frame, intersections, paths);
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

    /// The last analysis.
    #[must_use]
    pub fn last(&self) -> &Analysis {
        &self.analysis
    }
}

/// Analyses one frame of one mesh with the default settings; see [`Analyser`] for many frames.
#[must_use]
pub fn analyse(mesh: &Mesh, frame: &Frame) -> Analysis {
    let mut analyser = Analyser::default();
    analyser.analyse(mesh, frame, &Settings::default(), &mut ());
    analyser.analysis
}
