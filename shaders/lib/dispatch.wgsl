// Lays out dispatches of more workgroups than fit one dimension in rows. The plan-* stages
// compute the sizes on the GPU. Reference: packages/core/src/stages/dispatch.ts.

/// Number of this workgroup, counted along rows of `row` workgroups.
fn linearWorkgroup(workgroup: vec3u, row: u32) -> u32 {
  return workgroup.y * row + workgroup.x;
}

/// Dispatch size for `count` workgroups: a single row if they fit, else full rows.
fn dispatchSize(count: u32, row: u32) -> vec3u {
  return select(vec3u(row, (count + row - 1u) / row, 1u), vec3u(count, 1u, 1u), count <= row);
}
