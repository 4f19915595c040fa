import { type LoadPort, serveLoad } from './serve-load.ts';

serveLoad(self as unknown as LoadPort);
