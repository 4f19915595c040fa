import { type LoadPort, serveLoad } from '../../loading/serve-load.ts';
import { onlyOf } from '../splat-format.ts';
import { readZip } from './zip.ts';
import { zipFormat } from './zip-format.ts';

serveLoad(self as unknown as LoadPort, onlyOf(zipFormat, readZip));
