//! What is measured, and how it is told.

use std::error::Error;

use crate::{
    advice,
    exact::{self, POSITIONS},
    front::pareto_front,
    plot,
    run::{HELD, REMAINING_AFTER},
    setup,
    study::{Measured, Plan, measure},
    table::{self, Table},
};

/// On what is measured.
#[derive(Clone, Debug)]
pub(crate) struct Plans {
    /// Scenes for presets, single factors and the grid.
    pub(crate) main: Plan,
    /// Scenes with many paths, for deadlines.
    pub(crate) gallery: Plan,
    /// The main scenes with edges half as long, for responses.
    pub(crate) finer: Plan,
    /// Cells along the sides of the sheets for exact signs.
    pub(crate) resolution: u32,
}

/// All figures.
#[derive(Clone, Debug)]
pub(crate) struct Document {
    limit: usize,
    pub(crate) presets: Vec<Measured>,
    pub(crate) factors: Vec<Measured>,
    pub(crate) grid: Vec<Measured>,
    pub(crate) deadlines: Vec<Measured>,
    pub(crate) finer: Vec<Measured>,
    exact: Table,
}

impl Document {
    /// Measures everything.
    ///
    /// # Errors
    /// See [`measure`].
    pub(crate) fn measure(plans: &Plans) -> Result<Self, Box<dyn Error>> {
        let groups = [setup::presets(), setup::single_factors(), setup::grid()];
        let lengths = groups.each_ref().map(Vec::len);
        let mut measured = measure(&plans.main, &groups.concat())?.into_iter();
        let [presets, factors, grid] = lengths.map(|length| measured.by_ref().take(length).collect());
        let mut exact = Table::new(&["points", "sign ns", "triangles", "edge-face", "search ms"]);
        for (position, name) in POSITIONS {
            let cost = exact::measure(position, plans.resolution)?;
            exact.rows.push(vec![
                name.into(),
                format!("{:.0}", cost.sign_ns),
                cost.num_triangles.to_string(),
                cost.num_edge_face.to_string(),
                format!("{:.2}", cost.search_ms),
            ]);
        }
        Ok(Self {
            limit: plans.main.limit,
            presets,
            factors,
            grid,
            deadlines: measure(&plans.gallery, &setup::deadlines())?,
            finer: measure(&plans.finer, &setup::responses())?,
            exact,
        })
    }

    /// One row for each variant and scene.
    pub(crate) fn csv(&self) -> String {
        let all = [&self.presets, &self.factors, &self.grid, &self.deadlines, &self.finer];
        table::everything(all.into_iter().flatten(), self.limit).csv()
    }

    /// The picture.
    pub(crate) fn plot(&self) -> String {
        plot::svg(&self.grid, &self.presets, self.limit)
    }

    /// The points of the grid that a session may choose and that no other such point beats in all costs.
    pub(crate) fn front(&self) -> Vec<Measured> {
        let session: Vec<&Measured> = self.grid.iter().filter(|one| one.asks_always()).collect();
        let costs: Vec<[f64; 4]> = session.iter().map(|one| one.costs()).collect();
        pareto_front(&costs).into_iter().map(|index| session[index].clone()).collect()
    }

    /// The tables of the single factors, in order.
    fn factor_tables(&self) -> impl Iterator<Item = (&'static str, Table)> + '_ {
        let groups = self.factors.chunk_by(|a, b| a.variant.axis == b.variant.axis);
        groups.map(|group| (group[0].variant.axis, table::figures(group[0].variant.axis, group)))
    }

    /// The tables alone.
    pub(crate) fn plain(&self) -> String {
        let mut tables = vec![table::figures("preset", &self.presets)];
        tables.extend(self.factor_tables().map(|(_, table)| table));
        tables.push(table::figures("front", &self.front()));
        tables.push(table::figures("grid", &self.grid));
        tables.push(table::figures("half the edge", &self.finer));
        tables.push(table::figures("time for", &self.deadlines));
        tables.push(self.exact.clone());
        tables.iter().map(Table::plain).collect::<Vec<_>>().join("\n")
    }

    /// The whole document.
    pub(crate) fn markdown(&self, edge_m: f64, seeds: u64) -> String {
        let presets = table::figures("preset", &self.presets).markdown();
        let front = table::figures("front", &self.front()).markdown();
        let grid = table::figures("grid", &self.grid).markdown();
        let finer = table::figures("half the edge", &self.finer).markdown();
        let deadlines = table::figures("time for", &self.deadlines).markdown();
        let exact = self.exact.markdown();
        let limit = self.limit;
        let mut text = format!(
            "# Speed against accuracy\n\n\
             Made by `cargo run --release --example trade -- --out docs --markdown > docs/TRADE.md`; do not edit. The same command writes the\n\
             picture, and `trade.csv` with a row for each setting and scene. Times are of one busy machine's processor, to be compared within\n\
             this page only; all else is the same every time.\n\n\
             Scenes, simulator and exact check are those of `clients/publisher`: one scene for each type of path, {seeds} seeds, edges of {edge_m} m,\n\
             steps of 1/60 s, at most {limit}. The figures are means over all runs:\n\n\
             - `ms/frame`: analysis and response of a frame that is not clean, whether or not the host asked in it;\n\
             - `frames`: to the first clean frame that is followed by {HELD} more; a run that never was counts {limit}, and is counted in `not clean`;\n\
             - `remaining`: edge-face intersections after {REMAINING_AFTER} frames;\n\
             - `target error`, `worst`: distance of a target from the true one in edges, where the truth is known (the sheets of [TARGETS.md](TARGETS.md)):\n  \
               mean over the sheets, and the worst target; none for responses without targets;\n\
             - `distortion`: how far the worst edge is from its length at rest, as a factor, at the end;\n\
             - `force left`, `torque left`: what is left of momenta, as a part of the sum of lengths, at worst: of forces before the limit and the\n  \
               pins, of displacements as they are.\n\n\
             ![Time of a frame against frames to clean](trade.svg)\n\n\
             ## The presets\n\n{presets}\n"
        );
        text += &advice::text(self);
        text += &format!(
            "\n## The front\n\n\
             A session chooses response and centres, and with the host asking for every frame these points are beaten by no other in time, frames,\n\
             what remains and target error together:\n\n{front}\n{}\n\n\
             ## One factor at a time\n\nAll else as in `balanced`.\n",
            advice::presets_on_front(self)
        );
        for (axis, table) in self.factor_tables() {
            text += &format!("\n{}\n\n{}", advice::on_axis(axis), table.markdown());
        }
        text + &format!(
            "\n## Finer meshes\n\n{}\n\n{finer}\n\
             ## Less time for a frame\n\n{}\n\n{deadlines}\n\
             ## What exact signs cost\n\n{}\n\n{exact}\n\
             ## The grid\n\nEvery response, number of centres and n-th frame, the last correction used again in between.\n\n{grid}",
            advice::FINER,
            advice::DEADLINES,
            advice::EXACT
        )
    }
}
