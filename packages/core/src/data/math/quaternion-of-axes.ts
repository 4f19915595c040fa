/**
 * Quaternion w, x, y, z, of any length, that turns x, y, z to orthonormal axes.
 *
 * @param axes three rows of x, y, z; the last may point either way.
 */
export function quaternionOfAxes(axes: Float64Array): [number, number, number, number] {
  const [ax, ay, az, bx, by, bz] = axes;
  // Right-handed.
  const [cx, cy, cz] = [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx];
  // Each has the largest component of the quaternion once; the largest of them divides best.
  const squares = [1 + ax + by + cz, 1 + ax - by - cz, 1 - ax + by - cz, 1 - ax - by + cz];
  switch (squares.indexOf(Math.max(...squares))) {
    case 0:
      return [squares[0], bz - cy, cx - az, ay - bx];
    case 1:
      return [bz - cy, squares[1], ay + bx, cx + az];
    case 2:
      return [cx - az, ay + bx, squares[2], bz + cy];
    default:
      return [ay - bx, cx + az, bz + cy, squares[3]];
  }
}
