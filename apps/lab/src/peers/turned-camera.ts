import type { SceneCamera } from '@websplatter/scenes';

/** Turns a camera about the axis `up` through its target, by `angle` in radians. */
export function turnedCamera(camera: SceneCamera, angle: number): SceneCamera {
  const { target, up } = camera;
  const length = Math.hypot(...up);
  const [x, y, z] = up.map((value) => value / length);
  const [a, b, c] = camera.position.map((value, axis) => value - target[axis]);
  const along = (x * a + y * b + z * c) * (1 - Math.cos(angle));
  const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
  return {
    ...camera,
    position: [
      target[0] + x * along + a * cos + (y * c - z * b) * sin,
      target[1] + y * along + b * cos + (z * a - x * c) * sin,
      target[2] + z * along + c * cos + (x * b - y * a) * sin,
    ],
  };
}
