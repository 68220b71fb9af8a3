//! Sparse corrections, and which contacts have to be off by their labels.

use client::{ContactFilter, VertexLabel};

use crate::{
    error::{ErrorCode, Fault, guard},
    handles::{CONTACTS, SESSIONS, lock},
    input,
    types::{ContactsHandle, CorrectionView, Label, SessionHandle, SparseView},
};

/// Most contacts of one call, and most labels.
const MOST: usize = 1 << 31;

/// Whether a session gets sparse corrections, as asked for by `UNTANGLED_SPARSE`: not from a daemon that is too old.
#[unsafe(no_mangle)]
pub extern "C" fn untangled_is_sparse(session: SessionHandle) -> bool {
    SESSIONS.get(session.id).is_ok_and(|session| lock(&session).session.is_sparse())
}

/// Whether a session gets labels, as asked for by `UNTANGLED_LABELS`: not from a daemon that is too old.
#[unsafe(no_mangle)]
pub extern "C" fn untangled_has_labels(session: SessionHandle) -> bool {
    SESSIONS.get(session.id).is_ok_and(|session| lock(&session).session.has_labels())
}

/// Entries and labels of a correction that came sparse; of one that did not, `sparse` becomes all zero. The addresses
/// are valid as long as those of the correction.
///
/// # Safety
/// `correction` is null or points to one; `sparse` is null or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn untangled_sparse(
    session: SessionHandle,
    correction: *const CorrectionView,
    sparse: *mut SparseView,
) -> ErrorCode {
    guard(|| {
        // SAFETY: the caller's promise.
        let place = unsafe { input::place("sparse", sparse) }?;
        place.write(SparseView::default());
        if correction.is_null() || !correction.is_aligned() {
            return Err(Fault::argument("`correction` is null or not aligned"));
        }
        // SAFETY: checked as far as it can be; the rest is the caller's promise.
        let token = unsafe { &*correction }.token;
        let session = SESSIONS.get(session.id)?;
        place.write(SparseView::new(lock(&session).held(token)?));
        Ok(())
    })
}

/// Makes a filter for the contacts of a cloth of so many vertices; it switches none off. Free it with
/// `untangled_contacts_free`.
///
/// # Safety
/// `contacts` is null or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn untangled_contacts_create(num_vertices: usize, contacts: *mut ContactsHandle) -> ErrorCode {
    guard(|| {
        // SAFETY: the caller's promise.
        let place = unsafe { input::place("contacts", contacts) }?;
        place.write(ContactsHandle::default());
        if num_vertices > MOST {
            return Err(Fault::argument(format_args!("{num_vertices} vertices: too many")));
        }
        place.write(ContactsHandle { id: CONTACTS.add(ContactFilter::new(num_vertices)) });
        Ok(())
    })
}

/// Gives a filter back.
#[unsafe(no_mangle)]
pub extern "C" fn untangled_contacts_free(contacts: ContactsHandle) -> ErrorCode {
    guard(|| CONTACTS.remove(contacts.id).map(drop))
}

/// Gives a filter the labels of a frame, those of `untangled_sparse`, in place of those before. They are copied.
///
/// # Safety
/// `labels` is null or holds `num_labels` of them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn untangled_contacts_set(
    contacts: ContactsHandle,
    labels: *const Label,
    num_labels: usize,
) -> ErrorCode {
    guard(|| {
        // SAFETY: the caller's promise.
        let labels = unsafe { input::array("labels", labels.cast::<VertexLabel>(), num_labels, MOST) }?;
        let contacts = CONTACTS.get(contacts.id)?;
        lock(&contacts).set(labels.iter().map(|label| (label.vertex, label.label)));
        Ok(())
    })
}

/// Says of contacts between a vertex and a face each whether they have to be off: those between the two sides of one
/// pair of paths, and no others. `vertices` holds `num_contacts` indices, `faces` `num_contacts x 3`, those of the
/// corners; `off` becomes true or false for each. Indices beyond the cloth have no labels. Calls of several threads on
/// one filter wait for each other; let each thread have its own, or ask for many contacts at a time.
///
/// # Safety
/// `vertices` and `faces` are null or hold that many numbers; `off` is null or may be written so often.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn untangled_vertex_faces_off(
    contacts: ContactsHandle,
    vertices: *const u32,
    faces: *const u32,
    num_contacts: usize,
    off: *mut bool,
) -> ErrorCode {
    let is_off =
        |filter: &ContactFilter, vertex: &[u32; 1], face: &[u32; 3]| filter.vertex_face_is_off(vertex[0], *face);
    // SAFETY: the caller's promise.
    unsafe { answer(contacts, ["vertices", "faces"], vertices, faces, num_contacts, off, is_off) }
}

/// Says of contacts between two edges each whether they have to be off; `first` and `second` hold `num_contacts x 2`
/// indices of vertices. See `untangled_vertex_faces_off`.
///
/// # Safety
/// `first` and `second` are null or hold that many numbers; `off` is null or may be written so often.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn untangled_edge_edges_off(
    contacts: ContactsHandle,
    first: *const u32,
    second: *const u32,
    num_contacts: usize,
    off: *mut bool,
) -> ErrorCode {
    let is_off = |filter: &ContactFilter, first: &[u32; 2], second: &[u32; 2]| filter.edge_edge_is_off(*first, *second);
    // SAFETY: the caller's promise.
    unsafe { answer(contacts, ["first", "second"], first, second, num_contacts, off, is_off) }
}

/// Writes for each contact of two ends, of `A` and `B` vertices, whether it is off.
///
/// # Safety
/// The addresses are null or hold as many elements as that takes, `off` to be written.
unsafe fn answer<const A: usize, const B: usize>(
    contacts: ContactsHandle,
    names: [&str; 2],
    first: *const u32,
    second: *const u32,
    num_contacts: usize,
    off: *mut bool,
    is_off: impl Fn(&ContactFilter, &[u32; A], &[u32; B]) -> bool,
) -> ErrorCode {
    guard(|| {
        if num_contacts > MOST {
            return Err(Fault::argument(format_args!("{num_contacts} contacts: too many in one call")));
        }
        // SAFETY: the caller's promise.
        let (first, second) = unsafe {
            (
                input::array(names[0], first, A * num_contacts, 3 * MOST)?,
                input::array(names[1], second, B * num_contacts, 3 * MOST)?,
            )
        };
        if off.is_null() && num_contacts > 0 {
            return Err(input::null("off"));
        }
        let contacts = CONTACTS.get(contacts.id)?;
        let filter = lock(&contacts);
        for (k, (first, second)) in first.as_chunks().0.iter().zip(second.as_chunks().0).enumerate() {
            // SAFETY: the caller's promise; there are no more pairs than contacts.
            unsafe { off.add(k).write(is_off(&filter, first, second)) };
        }
        Ok(())
    })
}
