import { type LoadPort, serveLoad } from '../../loading/serve-load.ts';
import { PLY_READERS } from './read-ply.ts';

serveLoad(self as unknown as LoadPort, PLY_READERS);
