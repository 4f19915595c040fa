import { type LoadPort, serveLoad } from '../../loading/serve-load.ts';
import { onlyOf } from '../splat-format.ts';
import { readSplat } from './splat.ts';
import { splatFormat } from './splat-format.ts';

serveLoad(self as unknown as LoadPort, onlyOf(splatFormat, readSplat));
