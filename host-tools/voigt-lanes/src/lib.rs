//! What candidates of the Voigt family run through side by side: knots over the voltage between which a tick's
//! affine map is interpolated, a session as its steps, and exponentials that become vector instructions. Knows no
//! cost and no search.

pub mod branchless;
pub mod knots;
pub mod terms;
pub mod timeline;
