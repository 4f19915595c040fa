import { type LoadPort, serveLoad } from '../../loading/serve-load.ts';
import { onlyOf } from '../splat-format.ts';
import { readPly } from './ply.ts';
import { plyFormat } from './ply-format.ts';

serveLoad(self as unknown as LoadPort, onlyOf(plyFormat, readPly));
