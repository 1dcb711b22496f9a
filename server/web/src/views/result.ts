import type { View } from "../main"; export const showResult: View = async (host) => { host.append("result"); };
