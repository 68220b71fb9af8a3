//! Figures as tables, picture and text.

mod advice;
pub(crate) mod document;
mod front;
mod plot;
pub(crate) mod report;
mod table;
