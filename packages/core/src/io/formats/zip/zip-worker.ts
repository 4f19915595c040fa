import { type LoadPort, serveLoad } from '../../loading/serve-load.ts';
import { readZip } from './zip.ts';
import { zipFormat } from './zip-format.ts';

serveLoad(self as unknown as LoadPort, zipFormat, readZip);
