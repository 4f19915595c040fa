import { type LoadPort, serveLoad } from '../../loading/serve-load.ts';
import { readSog } from './sog.ts';
import { sogFormat } from './sog-format.ts';

serveLoad(self as unknown as LoadPort, sogFormat, readSog);
