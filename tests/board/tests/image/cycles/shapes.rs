//! What is fed to estimate and wanted of a drive, 0 … 1 of the range: what a stage does, and what costs a
//! tick the most.

/// Ticks of each shape.
pub const TICKS: u32 = 180;
/// How many shapes there are.
pub const SHAPES: u32 = 8;

/// The value of a tick, shape after shape.
pub fn shape(tick: u32) -> f32 {
    let (shape, tick) = (tick / TICKS, tick % TICKS);
    let t = tick as f32 * 5e-4;
    let up = tick % 2 == 0;
    let swing = |size: f32| if up { 0.5 + 0.5 * size } else { 0.5 - 0.5 * size };
    match shape {
        // Slow, with a ripple.
        0 => 0.5 - 0.47 * (t * 21.0).cos() + 0.02 * (t * 2_090.0).sin(),
        // A reversal from end to end at every tick.
        1 => swing(1.0),
        // Reversals that shrink, so that memories fill, and go on when they are full.
        2 => swing(1.0 - (tick % 60) as f32 / 60.0),
        // The same within what a drive's slew rate allows in a tick, also of a model that hardly moves after a
        // reversal, and in ten.
        3 => {
            let size = if tick < TICKS / 2 { 0.1 } else { 0.012 };
            swing(size - size * (tick % 45) as f32 / 45.0)
        }
        4 => {
            let (turn, part) = (tick / 10, (tick % 10) as f32 / 10.0);
            let size = 0.9 - 0.03 * turn as f32;
            if turn % 2 == 0 { 0.5 + size * (part - 0.5) } else { 0.5 - size * (part - 0.5) }
        }
        // Steps from end to end, with a rest.
        5 => f32::from(u8::from(tick / 10 % 2 == 0)),
        // Noise, large and small.
        6 => random(tick),
        _ => 0.5 - 0.45 * (t * 44.0).cos() + 0.02 * (random(tick) - 0.5),
    }
    .clamp(0.0, 1.0)
}

/// How far [`leaping`] goes in a tick at most where it does not leap.
pub const STEADY: f32 = 0.3;
/// Ticks from leap to leap: one in six is no fault.
pub const LEAPS: u32 = 6;

/// The same, smaller, low and high by turns; in between a tick that leaps away, after which it is back elsewhere.
pub fn leaping(tick: u32) -> f32 {
    let (turn, at) = (tick / LEAPS, tick % LEAPS);
    if at == LEAPS - 1 {
        return 1.0;
    }
    let high = if turn % 2 == 0 { 0.0 } else { STEADY };
    high + 0.95 * STEADY * shape(tick)
}

/// 0 … 1, the same for every tick of the same number.
fn random(tick: u32) -> f32 {
    let mixed = tick.wrapping_add(1).wrapping_mul(0x9E37_79B1);
    let mixed = (mixed ^ mixed >> 15).wrapping_mul(0x85EB_CA6B);
    (mixed >> 8) as f32 / 16_777_216.0
}
