//! The meshes below a prim: their polygons, the time codes of their points, and their transforms.

use super::{
    compose::{Attribute, ComposedPrim, Stage},
    fault::UsdError,
    mesh::MeshPrim,
    xform::Xform,
};
use crate::formats::{
    mesh_data::MeshData,
    part::{PartBuilder, PartName},
};

/// Most meshes and prims below one prim.
const MOST_PRIMS: usize = 100_000;

/// A mesh of a stage.
#[derive(Clone, Debug)]
pub(super) struct StageMesh {
    pub(super) path: String,
    pub(super) points: Attribute,
    pub(super) num_vertices: usize,
    pub(super) xform: Xform,
}

/// Collects meshes.
pub(super) struct Gathering<'s> {
    stage: &'s mut Stage,
    pub(super) meshes: Vec<StageMesh>,
    /// Polygons and parts of all meshes; positions are added later.
    pub(super) data: MeshData,
    parts: PartBuilder,
    num_vertices: usize,
    num_prims: usize,
    /// Bytes of mesh so far.
    num_bytes: u64,
}

impl<'s> Gathering<'s> {
    /// Collects the meshes of a prim and of all below it.
    pub(super) fn run(stage: &'s mut Stage, path: &str) -> Result<Self, UsdError> {
        let mut xform = Xform::default();
        let prims = stage.prims_to(path)?;
        for prim in &prims {
            if !prim.is_active() {
                return Err(stage.error(&prim.path, "is not active"));
            }
            if prim.is_instance() {
                return Err(stage.error(&prim.path, INSTANCE));
            }
            xform = xform.below(stage, prim)?;
        }
        let mut gathering = Self {
            stage,
            meshes: Vec::new(),
            data: MeshData::default(),
            parts: PartBuilder::default(),
            num_vertices: 0,
            num_prims: 0,
            num_bytes: 0,
        };
        if let Some(prim) = prims.last() {
            gathering.visit(prim, &xform)?;
        }
        let num_polygons = gathering.data.polygons.len();
        gathering.data.parts = std::mem::take(&mut gathering.parts).finish(num_polygons, gathering.num_vertices);
        if gathering.meshes.is_empty() {
            return Err(gathering.stage.error(path, "there is no mesh at it or below it that is drawn"));
        }
        Ok(gathering)
    }

    fn visit(&mut self, prim: &ComposedPrim, xform: &Xform) -> Result<(), UsdError> {
        self.num_prims += 1;
        if self.num_prims > MOST_PRIMS {
            return Err(self.stage.error(&prim.path, "there are too many prims up to here"));
        }
        if prim.type_name().as_deref() == Some("Mesh") {
            self.mesh(prim, xform)?;
        }
        for name in prim.children() {
            let child = self.stage.child(prim, &name)?;
            if !child.is_active() || !child.is_defined() || self.is_hidden(&child)? {
                continue;
            }
            if child.is_instance() {
                return Err(self.stage.error(&child.path, INSTANCE));
            }
            if child.type_name().as_deref() == Some("PointInstancer") {
                return Err(self.stage.error(&child.path, "is an instancer, whose copies can't be moved one by one"));
            }
            let xform = xform.below(self.stage, &child)?;
            self.visit(&child, &xform)?;
        }
        Ok(())
    }

    /// Whether it is a stand-in or invisible, which is no part of what is drawn.
    fn is_hidden(&self, prim: &ComposedPrim) -> Result<bool, UsdError> {
        for (name, hidden) in [("purpose", &["proxy", "guide"][..]), ("visibility", &["invisible"])] {
            if let Some(attribute) = prim.attribute(name)
                && let Some(value) = self.stage.default(&attribute)?
                && value.as_text().is_some_and(|text| hidden.contains(&text))
            {
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn mesh(&mut self, prim: &ComposedPrim, xform: &Xform) -> Result<(), UsdError> {
        let mesh = MeshPrim::read(self.stage, prim)?;
        self.num_bytes += mesh.num_bytes();
        if self.num_bytes > self.stage.budget() {
            return Err(self.stage.error(&prim.path, "asks for more mesh than the bytes of its files may"));
        }
        let name = PartName { kind: "prim", name: prim.path.as_str().into() };
        self.parts.rename(self.data.polygons.len(), self.num_vertices, |part| part.outer = Some(name));
        let appended = mesh.append(self.num_vertices, &mut self.data);
        appended.map_err(|reason| self.stage.error(&prim.path, reason))?;
        let MeshPrim { points, num_vertices, .. } = mesh;
        self.num_vertices += num_vertices;
        self.meshes.push(StageMesh { path: prim.path.clone(), points, num_vertices, xform: xform.clone() });
        Ok(())
    }
}

const INSTANCE: &str = "is an instance, and what is below it can't be moved by itself; make it no instance first";
