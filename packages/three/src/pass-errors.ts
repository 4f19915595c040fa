import { SplatsPassError } from './errors.ts';
import type { RefusalReason } from './three-bridge.ts';

const MESSAGES: Readonly<Record<RefusalReason, string>> = {
  'several-cameras':
    'Splats cannot be drawn with an ArrayCamera or in XR, for several cameras in a pass. Render each ' +
    'camera alone, in a viewport of its own, or hide the splats.',
  'lost-samples':
    'Splats cannot be drawn into a RenderTarget that loses its samples when they interrupt three’s pass. Leave its ' +
    'storeMultisampledColorBuffer, storeMultisampledDepthBuffer and storeMultisampledStencilBuffer on.',
  'unresolved-samples':
    'Splats cannot be drawn into a multisampled RenderTarget that is not resolved: set its resolveColorBuffer.',
  'part-of-texture':
    'Splats cannot be drawn into a slice or a mip level of a texture. Draw into a RenderTarget of its own and copy it, ' +
    'or hide the splats from this camera by layers.',
};

/** Returns the error that tells why splats are not drawn into a pass. */
export function passError(reason: RefusalReason): SplatsPassError {
  return new SplatsPassError(MESSAGES[reason]);
}
