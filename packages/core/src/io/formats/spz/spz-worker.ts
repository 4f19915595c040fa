import { type LoadPort, serveLoad } from '../../loading/serve-load.ts';
import { onlyOf } from '../splat-format.ts';
import { readSpz } from './spz.ts';
import { spzFormat } from './spz-format.ts';

serveLoad(self as unknown as LoadPort, onlyOf(spzFormat, readSpz));
