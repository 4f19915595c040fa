import type { Vec3 } from '../data/math/mat4.ts';
import { dot, plus } from '../data/math/vec3.ts';
import { chooseCamera } from './choose-camera.ts';
import { sinCos } from './portable-math.ts';
import { sceneDetail } from './scene-detail.ts';
import type { FramingWishes, SceneFraming } from './scene-framing.ts';
import type { SplatSample } from './splat-sample.ts';

/**
 * Frames the scene that `sample` was taken from; null if no splat of it can be seen. The same
 * arguments give the same result on every machine, bit for bit.
 */
export function frameSample(sample: SplatSample, wishes: FramingWishes): SceneFraming | null {
  const detail = sceneDetail(sample);
  if (!detail) return null;
  const { aspect, fovYDegrees } = wishes;
  const [sin, cos] = sinCos((fovYDegrees * Math.PI) / 360);
  const shape = { tangentX: (sin / cos) * aspect, tangentY: sin / cos };
  const chosen = chooseCamera(detail, shape, wishes);
  const { up, ground, confidence } = chosen.up;
  const { center, scale, reach } = detail;
  const world = (point: Vec3) => plus(center, point, scale);
  return {
    kind: chosen.kind,
    position: world(chosen.position),
    target: world(chosen.target),
    up,
    fovYDegrees,
    center,
    radius: scale * Math.max(1, reach),
    groundHeight: ground === null ? null : dot(center, up) + scale * ground,
    confidence: { up: confidence, kind: chosen.confidence },
  };
}
