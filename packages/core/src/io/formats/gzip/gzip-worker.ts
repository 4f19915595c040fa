import { type LoadPort, serveLoad } from '../../loading/serve-load.ts';
import { onlyOf } from '../splat-format.ts';
import { readGzip } from './gzip.ts';
import { gzipFormat } from './gzip-format.ts';

serveLoad(self as unknown as LoadPort, onlyOf(gzipFormat, readGzip));
