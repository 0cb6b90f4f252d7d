/* SPDX-License-Identifier: BSD-2-Clause */
/* Gauss-Legendre quadrature with eight points (gauss.h). */
#include "gauss.h"

gauss_point gauss_point_at(int i, double from, double to)
{
    static const double place[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                    0.9602898564975363};
    static const double weight[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                     0.1012285362903763};
    const double half = (to - from) / 2, side = i & 1 ? 1 : -1;
    const gauss_point point = {(from + to) / 2 + side * half * place[i / 2], half * weight[i / 2]};
    return point;
}
