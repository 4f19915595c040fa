import { InvalidArgumentError } from '../data/errors.ts';
import type { Vec3 } from '../data/math/mat4.ts';
import type { ImageDifference } from '../stages/measure/measure.reference.ts';
import { compareImages } from '../stages/measure/measure.ts';
import { compareTextures } from './compare-textures.ts';
import type { ComparedView } from './measured-engine.ts';

/**
 * Compares the last images of two views of the same engine on the GPU: only numbers are read back,
 * so it takes milliseconds at any size.
 *
 * @param background colour behind both, 0…1; default black.
 * @throws InvalidArgumentError if a view has no image yet or the sizes differ, NonFiniteImageError,
 * DestroyedError.
 * @example
 * const frame = { camera, clouds: [{ cloud }], widthPx, heightPx };
 * view.render(frame);
 * const reference = engine.createView();
 * reference.render({ ...frame, accuracy: 'reference' });
 * const { psnrDb } = await compareViews(view, reference);
 * reference.destroy();
 */
export async function compareViews(
  actual: ComparedView,
  expected: ComparedView,
  background?: Vec3,
): Promise<ImageDifference> {
  await Promise.all([actual.whenDrawn(), expected.whenDrawn()]);
  // Compile before taking the textures: meanwhile, either view could be drawn in another size.
  await actual.blended().context.pipelines.prepare([compareImages]);
  const [a, b] = [actual.blended(), expected.blended()];
  if (!a.color || !b.color) {
    const missing = a.color ? 'expected' : 'actual';
    throw new InvalidArgumentError(missing, `The view ${missing} has no image yet: call render first.`);
  }
  return compareTextures(a.context, a.color, b.color, background);
}
