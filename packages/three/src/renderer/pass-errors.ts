import { SplatsPassError } from '../errors.ts';
import type { RefusalReason } from './three-bridge.ts';

const MESSAGES: Readonly<Record<RefusalReason, string>> = {
  'layers-at-once':
    'Splats cannot be drawn in XR, or into several layers of a RenderTarget at once, with this release of three, which ' +
    'draws all of a layer at the end of its render. Install three 0.187.',
  'many-cameras':
    'Splats can be drawn for 16 cameras of an ArrayCamera at most, because a shader can read 16 textures. Render ' +
    'further cameras by an ArrayCamera of their own.',
  'unreadable-texture':
    'Splats cannot be drawn over an image that cannot be read: the textures of this XR session have neither the usage ' +
    'TEXTURE_BINDING nor COPY_SRC. Leave renderer.outputColorSpace at SRGBColorSpace, or set a tone mapping: three then ' +
    'draws into a target of its own first.',
  'lost-samples':
    'Splats cannot be drawn into a RenderTarget that loses its samples when they interrupt three’s pass. Leave its ' +
    'storeMultisampledColorBuffer, storeMultisampledDepthBuffer and storeMultisampledStencilBuffer on.',
  'unresolved-samples':
    'Splats cannot be drawn into a multisampled RenderTarget that is not resolved: set its resolveColorBuffer.',
  'part-of-texture':
    'Splats cannot be drawn into a slice or a mip level of a texture. Draw into a RenderTarget of its own and copy it, ' +
    'or hide the splats from this camera by layers.',
};

/** Returns the error for splats that are not drawn into a pass. */
export function passError(reason: RefusalReason): SplatsPassError {
  return new SplatsPassError(MESSAGES[reason]);
}
