import { type LoadPort, serveLoad } from '../../loading/serve-load.ts';
import { onlyOf } from '../splat-format.ts';
import { plyFormat } from './ply-format.ts';
import { read } from './read-ply.ts';

serveLoad(self as unknown as LoadPort, onlyOf(plyFormat, read));
