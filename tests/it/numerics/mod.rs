//! The numerics folder against certified values and against independent implementations.

mod distributions;
mod fit;
mod lar;
mod nist;
mod nist_models;
