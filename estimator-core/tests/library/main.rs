//! The library from outside, by what is public of it.

mod bits;
mod bouc_wen;
mod common;
mod duhem;
mod estimator;
mod generalised_prandtl_ishlinskii;
mod held;
mod interval;
mod inverse;
mod lagged;
mod laws;
mod maxwell_slip;
mod models;
mod narx;
mod narx_bound;
mod noise;
mod prandtl_ishlinskii;
mod precision;
mod preisach;
mod published;
mod remanence;
mod settling;
mod table;
mod voigt_chain;
