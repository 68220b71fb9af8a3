//! All figures of a measurement.

use std::error::Error;

use super::{
    front::pareto_front,
    plot,
    table::{self, Table},
};
use crate::measure::{
    exact::{self, POSITIONS},
    setup,
    study::{Measured, Plan, measure},
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
    pub(crate) limit: usize,
    pub(crate) presets: Vec<Measured>,
    pub(crate) factors: Vec<Measured>,
    pub(crate) grid: Vec<Measured>,
    pub(crate) deadlines: Vec<Measured>,
    pub(crate) finer: Vec<Measured>,
    pub(crate) exact: Table,
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
    pub(crate) fn factor_tables(&self) -> impl Iterator<Item = (&'static str, Table)> + '_ {
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
}
