//! Registrations: a caller describes its cloth.

use std::ffi::c_char;

use client::{CorrectionKind, Precision, Registration, Uvs};

use crate::{
    error::{ErrorCode, Fault, guard},
    input,
    types::{Kind, PositionPrecision, UNTANGLED_LABELS, UNTANGLED_REPAIRS, UNTANGLED_SPARSE, UNTANGLED_WELD},
};

/// A cloth and what is asked for. Fill it with `untangled_registration_init` first; only `num_vertices` and `triangles`
/// are required.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ClothRegistration {
    /// Set by `untangled_registration_init`; a library whose structure has another size refuses it.
    pub struct_size: usize,
    /// Number of vertices.
    pub num_vertices: usize,
    /// Vertex indices, `num_triangles x 3`.
    pub triangles: *const u32,
    /// Number of triangles.
    pub num_triangles: usize,
    /// Texture coordinates, `num_uv_coordinates x 2`, or null.
    pub uv_coordinates: *const f64,
    /// Number of texture coordinates.
    pub num_uv_coordinates: usize,
    /// For each triangle the texture coordinate of its corners, `num_triangles x 3`; null only without texture
    /// coordinates.
    pub uv_corners: *const u32,
    /// Unstrained positions in metres, `num_vertices x 3`, or null.
    pub rest_positions_m: *const f64,
    /// Mass of each vertex in kilograms, or null; needed for forces.
    pub masses_kg: *const f64,
    /// Vertices that the host does not let move, or null.
    pub pins: *const u32,
    /// Number of pins.
    pub num_pins: usize,
    /// Layer of each vertex, from the body outwards, or null.
    pub layers: *const u32,
    /// `UNTANGLED_F32` (as `untangled_registration_init` leaves it) or `UNTANGLED_F64`.
    pub precision: u32,
    /// `UNTANGLED_FORCE` and so on; `UNTANGLED_DISPLACEMENT` as `untangled_registration_init` leaves it.
    pub correction: u32,
    /// 1 to receive intersection paths with each correction, else 0.
    pub paths: u32,
    /// Sum of `UNTANGLED_SPARSE` and so on; 0 for none.
    pub options: u32,
    /// Settings by name as a JSON object, as in `untangled config`; null for the daemon's defaults.
    pub settings_json: *const c_char,
}

/// Most vertices and faces that any daemon takes.
pub(crate) const MOST: usize = 1 << 25;

/// Writes what a registration is before anything is said: empty, single precision, displacements.
///
/// # Safety
/// `registration` is null, or a registration may be written there.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn untangled_registration_init(registration: *mut ClothRegistration) -> ErrorCode {
    guard(|| {
        // SAFETY: the caller's promise.
        let place = unsafe { input::place("registration", registration) }?;
        place.write(ClothRegistration {
            struct_size: size_of::<ClothRegistration>(),
            num_vertices: 0,
            triangles: std::ptr::null(),
            num_triangles: 0,
            uv_coordinates: std::ptr::null(),
            num_uv_coordinates: 0,
            uv_corners: std::ptr::null(),
            rest_positions_m: std::ptr::null(),
            masses_kg: std::ptr::null(),
            pins: std::ptr::null(),
            num_pins: 0,
            layers: std::ptr::null(),
            precision: PositionPrecision::F32 as u32,
            correction: Kind::Displacement as u32,
            paths: 0,
            options: 0,
            settings_json: std::ptr::null(),
        });
        Ok(())
    })
}

impl ClothRegistration {
    /// Copies the arrays that the caller's addresses point to.
    ///
    /// # Safety
    /// Every address is null, or as many elements lie there as the fields say.
    pub(crate) unsafe fn read(&self) -> Result<Registration, Fault> {
        self.check_sizes()?;
        let (num_vertices, num_corners, most) = (self.num_vertices, 3 * self.num_triangles, 6 * MOST);
        // SAFETY: the caller's promise, for all of them.
        let (triangles, uvs, rest, masses, pins, layers, settings) = unsafe {
            (
                input::array("triangles", self.triangles, num_corners, most)?,
                self.read_uvs(most)?,
                input::optional("rest_positions_m", self.rest_positions_m, 3 * num_vertices, most)?,
                input::optional("masses_kg", self.masses_kg, num_vertices, most)?,
                input::array("pins", self.pins, self.num_pins, most)?,
                input::optional("layers", self.layers, num_vertices, most)?,
                input::text("settings_json", self.settings_json)?,
            )
        };
        Ok(Registration {
            num_vertices,
            triangles: triangles.as_chunks().0.to_vec(),
            uvs,
            rest_positions: rest.map(|rest| rest.as_chunks().0.to_vec()),
            masses_kg: masses.map(<[f64]>::to_vec),
            pins: pins.to_vec(),
            layers: layers.map(<[u32]>::to_vec),
            body: Vec::new(),
            precision: precision(self.precision)?,
            correction: correction(self.correction)?,
            sparse: self.options & UNTANGLED_SPARSE != 0,
            labels: self.options & UNTANGLED_LABELS != 0,
            paths: flag("paths", self.paths)?,
            repairs: self.options & UNTANGLED_REPAIRS != 0,
            weld: self.options & UNTANGLED_WELD != 0,
            settings: settings.map_or(Ok(serde_json::Value::Null), parse)?,
        })
    }

    fn check_sizes(&self) -> Result<(), Fault> {
        if self.options & !(UNTANGLED_SPARSE | UNTANGLED_LABELS | UNTANGLED_REPAIRS | UNTANGLED_WELD) != 0 {
            let options = self.options;
            return Err(Fault::argument(format_args!("`options` is {options}, with bits that are not known")));
        }
        if self.struct_size != size_of::<Self>() {
            let (given, expected) = (self.struct_size, size_of::<Self>());
            return Err(Fault::argument(format_args!(
                "`struct_size` is {given}, not {expected}: call untangled_registration_init, with the header of this \
                 library"
            )));
        }
        let (num_vertices, num_faces) = (self.num_vertices, self.num_triangles);
        if num_vertices > MOST || num_faces > MOST || self.num_uv_coordinates > 3 * MOST || self.num_pins > MOST {
            return Err(Fault::argument(format_args!(
                "{num_vertices} vertices, {num_faces} triangles, {} texture coordinates, {} pins: too many",
                self.num_uv_coordinates, self.num_pins
            )));
        }
        Ok(())
    }

    /// Copies the texture coordinates, at most `most` numbers each.
    ///
    /// # Safety
    /// As [`read`](Self::read).
    unsafe fn read_uvs(&self, most: usize) -> Result<Option<Uvs>, Fault> {
        let (num_numbers, num_corners) = (2 * self.num_uv_coordinates, 3 * self.num_triangles);
        // SAFETY: the caller's promise.
        let (uvs, corners) = unsafe {
            (
                input::optional("uv_coordinates", self.uv_coordinates, num_numbers, most)?,
                input::optional("uv_corners", self.uv_corners, num_corners, most)?,
            )
        };
        match (uvs, corners) {
            (None, None) => Ok(None),
            (Some(coordinates), Some(corners)) => Ok(Some(Uvs {
                coordinates: coordinates.as_chunks().0.to_vec(),
                corners: corners.as_chunks().0.to_vec(),
            })),
            _ => Err(Fault::argument("`uv_coordinates` and `uv_corners` go together")),
        }
    }
}

fn precision(code: u32) -> Result<Precision, Fault> {
    Precision::from_code(code).ok_or_else(|| Fault::argument(format_args!("`precision` is {code}; it must be 0 or 1")))
}

fn correction(code: u32) -> Result<CorrectionKind, Fault> {
    CorrectionKind::from_code(code)
        .ok_or_else(|| Fault::argument(format_args!("`correction` is {code}; it must be 0 to 3")))
}

fn flag(name: &str, value: u32) -> Result<bool, Fault> {
    match value {
        0 => Ok(false),
        1 => Ok(true),
        other => Err(Fault::argument(format_args!("`{name}` is {other}; it must be 0 or 1"))),
    }
}

/// Settings from a JSON text.
pub(crate) fn parse(settings: &str) -> Result<serde_json::Value, Fault> {
    serde_json::from_str(settings).map_err(|error| Fault::argument(format_args!("`settings_json` is no JSON: {error}")))
}
