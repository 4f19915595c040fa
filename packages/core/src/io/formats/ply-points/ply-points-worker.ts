import { type LoadPort, serveLoad } from '../../loading/serve-load.ts';
import { onlyOf } from '../splat-format.ts';
import { readPlyPoints } from './ply-points.ts';
import { plyPointsFormat } from './ply-points-format.ts';

serveLoad(self as unknown as LoadPort, onlyOf(plyPointsFormat, readPlyPoints));
