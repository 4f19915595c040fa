// The last release with PlayCanvas's rasteriser in compute shaders: 2.20 has none.
import * as pc from 'playcanvas-2.19.7';
import { playCanvasPeer } from './playcanvas-peer.js';

export { formats } from './playcanvas-peer.js';

export default playCanvasPeer(pc, 'GSPLAT_RENDERER_COMPUTE');
