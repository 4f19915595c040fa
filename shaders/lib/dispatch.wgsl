// Dispatches of more workgroups than one dimension takes are laid out in rows.

/// Number of this workgroup, counting along rows of `row` workgroups.
fn linearWorkgroup(workgroup: vec3u, row: u32) -> u32 {
  return workgroup.y * row + workgroup.x;
}

/// Dispatch size for `count` workgroups: one row, or as many full rows as it takes.
fn dispatchSize(count: u32, row: u32) -> vec3u {
  return select(vec3u(row, (count + row - 1u) / row, 1u), vec3u(count, 1u, 1u), count <= row);
}
