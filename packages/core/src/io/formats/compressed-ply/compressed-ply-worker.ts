import { type LoadPort, serveLoad } from '../../loading/serve-load.ts';
import { onlyOf } from '../splat-format.ts';
import { readCompressedPly } from './compressed-ply.ts';
import { compressedPlyFormat } from './compressed-ply-format.ts';

serveLoad(self as unknown as LoadPort, onlyOf(compressedPlyFormat, readCompressedPly));
