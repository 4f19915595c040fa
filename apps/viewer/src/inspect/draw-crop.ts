import { clip } from '@websplatter/core/effects';
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
  if (crop) viewer.setEffects('crop', [clip({ volumes: [clipVolume(crop, isFlipped)] })]);
  else if (requested.crop.length > 0) viewer.setEffects('crop', []);
}

/** The clip volume for a crop in the scene's current orientation. */
export function clipVolume({ min, max, keep }: Crop, isFlipped: boolean) {
  const center = scale(add(min, max), 0.5);
  // A half turn around x keeps the edges parallel to the axes.
  return {
    shape: 'box',
    center: isFlipped ? flippedPoint(center) : center,
    size: subtract(max, min),
    keep,
  } as const;
}
