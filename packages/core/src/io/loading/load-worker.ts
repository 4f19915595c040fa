import { readPly } from '../formats/ply/ply.ts';
import { plyFormat } from '../formats/ply/ply-format.ts';
import { onlyOf } from '../formats/splat-format.ts';
import { type LoadPort, serveLoad } from './serve-load.ts';

serveLoad(self as unknown as LoadPort, onlyOf(plyFormat, readPly));
