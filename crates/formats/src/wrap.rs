//! Closed directions: the control points of one period, repeated to go with unrolled knots.

/// Row-major `items`, n_u × n_v, with the first p rows or columns repeated at the end of each direction for which a
/// degree p is given, as [`nurbs::KnotVector::periodic`] asks for; where p > n they go round more than once.
pub(crate) fn wrap<T: Copy>(items: &[T], [nu, nv]: [usize; 2], [wrap_u, wrap_v]: [Option<usize>; 2]) -> Vec<T> {
    let (rows, columns) = (nu + wrap_u.unwrap_or(0), nv + wrap_v.unwrap_or(0));
    (0..rows).flat_map(|i| (0..columns).map(move |j| items[i % nu * nv + j % nv])).collect()
}

#[cfg(test)]
mod tests {
    use super::wrap;

    #[test]
    fn rows_and_columns_repeat_from_the_start() {
        let items = [11, 12, 21, 22];
        assert_eq!(wrap(&items, [2, 2], [None, None]), items);
        assert_eq!(wrap(&items, [2, 2], [Some(1), None]), [11, 12, 21, 22, 11, 12]);
        assert_eq!(wrap(&items, [2, 2], [None, Some(3)]), [11, 12, 11, 12, 11, 21, 22, 21, 22, 21]);
    }
}
