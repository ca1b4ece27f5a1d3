//! The order of a graph by approximate minimum degree (Amestoy, Davis, Duff), by the crate feral-amd.

use feral_amd::{amd_order_with_stats, CscPattern};

use crate::error::{Error, Kind, Result};

/// Nodes in the order of their elimination, and the multiplications of the factorisation with one dof per node; the neighbours of
/// node i, without itself, are `adj[ptr[i]..ptr[i + 1]]`.
pub fn minimum_degree(ptr: &[i32], adj: &[i32]) -> Result<(Vec<usize>, f64)> {
    let failed = |why: String| Error::new(Kind::Internal, format!("minimum degree failed: {why}"));
    let pattern = CscPattern::new(ptr.len() - 1, ptr, adj).ok_or_else(|| failed("no graph".into()))?;
    let (order, stats) = amd_order_with_stats(&pattern).map_err(|e| failed(format!("{e:?}")))?;
    Ok((order.into_iter().map(|node| node as usize).collect(), stats.nms_ldl as f64))
}
