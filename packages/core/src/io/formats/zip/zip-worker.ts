import { browserDecoder } from '../../containers/browser-webp.ts';
import { type LoadPort, serveLoad } from '../../loading/serve-load.ts';
import { onlyOf } from '../splat-format.ts';
import { readZip } from './zip.ts';
import { zipFormat } from './zip-format.ts';

// Most archives are SOG. The answer is there before the images are.
void browserDecoder();
serveLoad(self as unknown as LoadPort, onlyOf(zipFormat, readZip));
