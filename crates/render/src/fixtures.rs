//! Inputs of tests.
