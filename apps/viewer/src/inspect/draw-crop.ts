import { volumes } from '@websplatter/core/effects';
import { flippedPoint } from '../camera/flip.ts';
import type { Crop } from '../state/inspecting.ts';
import { add, scale, subtract } from '../state/vec3.ts';
import type { InspectTools } from './inspect-tools.ts';

/** Draws the splats that the crop keeps, in the scene's current orientation. */
export function drawCrop({
  store,
  viewer,
}: Pick<InspectTools, 'store'> & { viewer: Pick<InspectTools['viewer'], 'setEffects'> }): void {
  const { isFlipped, inspecting, requested } = store.getState();
  const { crop } = inspecting;
  if (crop) viewer.setEffects('crop', [volumes([cropVolume(crop, isFlipped)])]);
  else if (requested.crop.length > 0) viewer.setEffects('crop', []);
}

/** The volume for a crop in the scene's current orientation. */
export function cropVolume({ min, max, keep }: Crop, isFlipped: boolean) {
  const center = scale(add(min, max), 0.5);
  // A half turn around x keeps the edges parallel to the axes.
  return {
    shape: 'box',
    mode: keep === 'inside' ? 'keep' : 'hide',
    center: isFlipped ? flippedPoint(center) : center,
    size: subtract(max, min),
  } as const;
}
