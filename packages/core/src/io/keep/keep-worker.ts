import type { KeepPort } from './keep-messages.ts';
import { serveKeep } from './serve-keep.ts';

serveKeep(self as unknown as KeepPort);
