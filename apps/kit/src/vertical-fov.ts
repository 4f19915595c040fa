/**
 * Vertical field of view, in degrees, of an image that shows `fovDegrees` over its shorter side. An
 * upright phone then shows as much as a wide window.
 */
export function verticalFov(fovDegrees: number, aspect: number): number {
  const halfTangent = Math.tan((fovDegrees * Math.PI) / 360) / Math.min(1, aspect);
  return (Math.atan(halfTangent) * 360) / Math.PI;
}
