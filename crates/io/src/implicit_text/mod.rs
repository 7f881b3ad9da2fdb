//! Implicit shapes in text.
mod foreign;
