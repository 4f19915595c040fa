import { type LoadPort, serveLoad } from '../../loading/serve-load.ts';
import { onlyOf } from '../splat-format.ts';
import { readKsplat } from './ksplat.ts';
import { ksplatFormat } from './ksplat-format.ts';

serveLoad(self as unknown as LoadPort, onlyOf(ksplatFormat, readKsplat));
