import * as pc from 'playcanvas';
import { playCanvasPeer } from './playcanvas-peer.js';

export { formats } from './playcanvas-peer.js';

export default playCanvasPeer(pc);
