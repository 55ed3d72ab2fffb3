//! The Everett function of a Preisach density that is constant in each cell of a triangular grid.
//!
//! `E(α, β)` (µm) is the mass of the triangle `β ≤ β' ≤ α' ≤ α` of the Preisach plane, Eq. (3.18): what a rise from β
//! to α adds to the displacement, or a fall from α to β takes away. Voltages are in units of the grid, 0…n.
//!
//! Its values at the nodes are summed once. Between them it is exact for this density: bilinear in the rectangles, plus
//! the quadratic parts of the two half cells at the diagonal that the triangle's tips lie in. Every term is a
//! non-negative coefficient (a sum of cells) times something that grows with α and falls with β.

use crate::math::Real;

/// Most cells along an edge of the plane.
pub const SIDE: usize = 10;
/// Most cells of the plane, the half cells at the diagonal included.
pub const CELLS: usize = SIDE * (SIDE + 1) / 2;
const NODES: usize = (SIDE + 1) * (SIDE + 2) / 2;

/// Where the cell (or node) of this row (α) and column (β ≤ α) is in the lists.
pub(super) fn place(row: usize, column: usize) -> usize {
    row * (row + 1) / 2 + column
}

/// Cells along an edge of a plane that has so many.
pub(super) fn side(cells: usize) -> Option<usize> {
    (1..=SIDE).find(|&side| place(side, 0) == cells)
}

/// The Everett function.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Everett<T> {
    side: usize,
    /// µm; of the half cells the half.
    cells: [T; CELLS],
    nodes: [T; NODES],
}

impl<T: Real> Everett<T> {
    /// Of these masses of whole cells (µm), row by row. Numbers behind the last complete row count for nothing.
    pub fn build(densities: &[f32]) -> Self {
        let side = (1..=SIDE).take_while(|&side| place(side, 0) <= densities.len()).last().unwrap_or(1);
        let mut everett = Self { side, cells: [T::zero(); CELLS], nodes: [T::zero(); NODES] };
        for row in 0..side {
            // Cells of the row from the diagonal to this column.
            let mut sum = T::zero();
            for column in (0..=row).rev() {
                let density = T::of(densities.get(place(row, column)).copied().unwrap_or(0.0));
                let mass = if column == row { density * T::of(0.5) } else { density };
                if let Some(cell) = everett.cells.get_mut(place(row, column)) {
                    *cell = mass;
                }
                sum = sum + mass;
                let below = everett.node(row, column);
                if let Some(node) = everett.nodes.get_mut(place(row + 1, column)) {
                    *node = below + sum;
                }
            }
        }
        everett
    }

    pub fn side(&self) -> usize {
        self.side
    }

    /// The highest voltage, in units of the grid.
    pub fn end(&self) -> T {
        T::of(self.side as f32)
    }

    fn node(&self, row: usize, column: usize) -> T {
        self.nodes.get(place(row, column)).copied().unwrap_or(T::zero())
    }

    fn cell(&self, row: usize, column: usize) -> T {
        self.cells.get(place(row, column)).copied().unwrap_or(T::zero())
    }

    /// The cell along an edge that a voltage of 0…n lies in, and how far into it, 0…1.
    #[inline]
    fn locate(&self, at: T) -> (usize, T) {
        let index = at.to_u32_saturating() as usize;
        let index = if index < self.side { index } else { self.side - 1 };
        (index, at - T::of(index as f32))
    }

    /// E(α, β), µm, for 0 ≤ β ≤ α ≤ n.
    #[inline]
    pub fn between(&self, alpha: T, beta: T) -> T {
        let ((row, s), (column, t)) = (self.locate(alpha), self.locate(beta));
        let row_tip = self.cell(row, row);
        if row <= column {
            let side = s - t;
            return row_tip * side * side;
        }
        let u = T::one() - t;
        let column_tip = self.cell(column, column);
        let whole = self.node(row, column + 1);
        let in_column = self.node(row, column) - whole - column_tip;
        let in_row = self.node(row + 1, column + 1) - whole - row_tip;
        let corner = self.cell(row, column);
        whole + u * (in_column + u * column_tip) + s * (in_row + s * row_tip + u * corner)
    }

    /// The part of a cell's whole area that lies in the triangle `β…α`; at most ½ of a half cell's.
    pub fn part(row: usize, column: usize, alpha: T, beta: T) -> T {
        let into = |at: T, index: usize| {
            let into = at - T::of(index as f32);
            let raised = if into > T::zero() { into } else { T::zero() };
            if raised < T::one() { raised } else { T::one() }
        };
        let (s, t) = (into(alpha, row), into(beta, column));
        if row != column {
            return s * (T::one() - t);
        }
        let side = if s > t { s - t } else { T::zero() };
        side * side * T::of(0.5)
    }
}
