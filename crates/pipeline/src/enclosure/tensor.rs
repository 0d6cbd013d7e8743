//! The sums of a tensor product with their errors, and the derivatives of results by the basis functions.

use super::basis::{Basis, BasisAdjoint};
use super::error::{Adjoint, Budget, Error, FLUSH, NARROWING, NEIGHBOUR};
use crate::layout::FaceRecord;

/// Orders of derivative (a, b) of the sums: A, A_u, A_v, and the second ones.
pub(super) const ORDERS: [[usize; 2]; 6] = [[0, 0], [1, 0], [0, 1], [2, 0], [1, 1], [0, 2]];

/// What the f64 arithmetic of raising a degree may leave in a control point, in local units.
const RAISING: f64 = 1.0 / (1u64 << 44) as f64;

/// A vector of homogeneous coordinates; w stays zero on a polynomial face.
type Homogeneous = [f64; 4];

/// The sums Σ N⁽ᵃ⁾_i N⁽ᵇ⁾_j P_ij of one place.
pub(super) struct Sums<const CAPACITY: usize> {
    pub value: [Homogeneous; 6],
    /// Coarse, all errors together.
    pub radius: [Homogeneous; 6],
    /// Of the sums alone: those of the basis are charged in its own sweep.
    local: [[Error; 4]; 6],
    /// Σ_j N⁽ᵇ⁾_j P_ij and Σ_i N⁽ᵃ⁾_i P_ij.
    rows: [[Homogeneous; CAPACITY]; 3],
    columns: [[Homogeneous; CAPACITY]; 3],
    /// 3, and 4 where there are weights.
    pub components: usize,
    orders: usize,
}

/// A row's sum on its way into the six.
#[derive(Clone, Copy, Default)]
struct Row {
    value: f64,
    /// Σ |N_j P_ij|.
    size: f64,
    /// Errors: of the basis, coarse; of the row's own roundings.
    carried: f64,
    own: f64,
}

impl<const CAPACITY: usize> Sums<CAPACITY> {
    /// The sums on two spans whose control points begin at `first`; `orders` is how many of [`ORDERS`] are wanted, 3 or 6.
    pub fn new(
        face: &FaceRecord,
        points: &[[f32; 4]],
        first: [usize; 2],
        [nu, nv]: [&Basis<CAPACITY>; 2],
        components: usize,
        orders: usize,
    ) -> Self {
        let zero = [0.0; 4];
        let mut sums = Self {
            value: [zero; 6],
            radius: [zero; 6],
            local: [[Error::ZERO; 4]; 6],
            rows: [[zero; CAPACITY]; 3],
            columns: [[zero; CAPACITY]; 3],
            components,
            orders,
        };
        let [p, q] = [face.degree_u as usize, face.degree_v as usize];
        let kinds = if orders == 6 { 3 } else { 2 };
        // Σ |terms| and Σ |N_u| × Σ |N_v|, for the greatest partial sums and for narrowing.
        let mut sizes = [zero; 6];
        let mut weights = [0.0; 6];
        // Functions beyond the degree are zero.
        let lengths: [f64; 3] = std::array::from_fn(|b| nv.functions[b].value.iter().map(|n| n.abs()).sum());
        for i in 0..=p {
            let start = face.points as usize + (first[0] + i) * face.count_v as usize + first[1];
            let points = &points[start..=start + q];
            for c in 0..components {
                let mut rows = [Row::default(); 3];
                for (j, point) in points.iter().enumerate() {
                    let x = f64::from(point[c]);
                    for b in 0..kinds {
                        let n = nv.functions[b].value[j];
                        rows[b].value += n * x;
                        rows[b].size += (n * x).abs();
                        rows[b].carried += nv.functions[b].radius[j] * x.abs();
                        rows[b].own += FLUSH * (4.0 + n.abs() + x.abs());
                    }
                    for a in 0..kinds {
                        sums.columns[a][j][c] += nu.functions[a].value[i] * x;
                    }
                }
                for b in 0..kinds {
                    let row = &mut rows[b];
                    row.own += roundings(q, row.size + row.carried, row.value.abs() + row.carried);
                    sums.rows[b][i][c] = row.value;
                }
                for (order, [a, b]) in ORDERS.into_iter().enumerate().take(orders) {
                    let (n, radius, row) = (nu.functions[a].value[i], nu.functions[a].radius[i], rows[b]);
                    let row_radius = row.carried + row.own;
                    let beyond = radius * row_radius;
                    sums.value[order][c] += n * row.value;
                    sizes[order][c] += n.abs() * row.value.abs();
                    sums.radius[order][c] += n.abs() * row_radius + radius * row.value.abs() + beyond;
                    sums.local[order][c] += Error {
                        rounding: n.abs() * row.own + beyond + FLUSH * (4.0 + n.abs() + row.value.abs()),
                        packing: beyond + n.abs() * NARROWING * row.size,
                    };
                }
            }
            for (order, [a, b]) in ORDERS.into_iter().enumerate().take(orders) {
                weights[order] += nu.functions[a].value[i].abs() * lengths[b];
            }
        }
        for order in 0..orders {
            for c in 0..components {
                let radius = &mut sums.radius[order][c];
                let local = &mut sums.local[order][c];
                local.rounding += roundings(p, sizes[order][c] + *radius, sums.value[order][c].abs() + *radius);
                local.packing += RAISING * weights[order];
                *radius += local.total();
            }
        }
        sums
    }

    /// Charges the sums' own errors, and takes the derivatives of the results by the sums on to the basis functions.
    pub fn sweep(&self, of_sums: &[[Adjoint; 4]; 6], budget: &mut Budget) -> [BasisAdjoint<CAPACITY>; 2] {
        let mut adjoints = [[[Adjoint::ZERO; CAPACITY]; 3]; 2];
        for (order, [a, b]) in ORDERS.into_iter().enumerate().take(self.orders) {
            for c in 0..self.components {
                let adjoint = &of_sums[order][c];
                budget.charge(adjoint, self.local[order][c]);
                for i in 0..CAPACITY {
                    adjoints[0][a][i].add(adjoint, self.rows[b][i][c]);
                    adjoints[1][b][i].add(adjoint, self.columns[a][i][c]);
                }
            }
        }
        adjoints
    }
}

/// Roundings of `degree` + 1 products and their sum in any order: no partial sum exceeds the greater of the positive
/// and the negative part, (Σ |terms| + |Σ terms|) / 2.
pub(super) fn roundings(degree: usize, size: f64, sum: f64) -> f64 {
    NEIGHBOUR * (size + degree as f64 * 0.5 * (size + sum)) * (1.0 + NEIGHBOUR)
}
