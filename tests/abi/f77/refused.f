C     Refused calls: the status counts the arguments of the FORTRAN 77
C     call, the text says what was wrong, nothing is changed.
      PROGRAM REFUSE
      INCLUDE 'feti_contact_f77.inc'
      INTEGER IP, IQ, IERR, I, N, L, IPTR(3), ICOL(4), IBOD(2), IS(2)
      DOUBLE PRECISION A(4), R(2), C(2), D
      CHARACTER TEXT*200
      DATA IPTR / 1, 2, 4 /, ICOL / 1, 1, 2, 1 /, IBOD / 2, 2 /
      DATA A / 5D1, -5D1, 5D1, 0D0 /, R / 1D0, 1D0 /, C / 0D0, 0D0 /
      CALL SMALL(IP)
C     Handles: none, never given, destroyed.
      DO 10 I = -1, 1
        IQ = 1000000 * I
        CALL FTBADD(IQ, 2, N, IERR)
        CALL NOT(IERR, FTEHDL, 'handle')
        CALL FTACTV(IQ, 2, IS, IERR)
        CALL NOT(IERR, FTEHDL, 'handle')
        CALL FTFREE(IQ, IERR)
        CALL NOT(IERR, FTEHDL, 'handle')
   10   CALL HOLDS(IQ .EQ. 1000000 * I, 'FTFREE changes a bad handle')
      CALL SMALL(IQ)
      N = IQ
      CALL FTFREE(IQ, IERR)
      CALL OK(IERR, 'FTFREE')
      CALL FTSTUP(N, IERR)
      CALL NOT(IERR, FTEHDL, 'handle')
C     Bodies: number, unknowns, storage, columns, null space, node.
      CALL FTBADD(IP, 0, N, IERR)
      CALL NOT(IERR, FTEARG - 2, ' ')
      CALL FTBSTF(IP, 0, 2, IPTR, ICOL, A, FTLOWR, IERR)
      CALL NOT(IERR, FTEARG - 2, ' ')
      CALL FTBSTF(IP, -1, 2, IPTR, ICOL, A, FTLOWR, IERR)
      CALL NOT(IERR, FTEARG - 2, ' ')
      CALL FTBSTF(IP, 2, 3, IPTR, ICOL, A, FTLOWR, IERR)
      CALL NOT(IERR, FTEARG - 3, ' ')
      CALL FTBSTF(IP, 2, 2, IPTR, ICOL, A, 7, IERR)
      CALL NOT(IERR, FTEARG - 7, 'FETI_FULL')
      ICOL(2) = 3
      CALL FTBSTF(IP, 2, 2, IPTR, ICOL, A, FTLOWR, IERR)
      CALL NOT(IERR, FTEARG - 5, 'row 2, entry 2')
      ICOL(2) = 1
      CALL FTBDNS(IP, 2, 2, A, 1, FTFULL, IERR)
      CALL NOT(IERR, FTEARG - 5, ' ')
      CALL FTBDNS(IP, 2, 2, A, 2, 3, IERR)
      CALL NOT(IERR, FTEARG - 6, ' ')
      CALL FTBNUL(IP, 2, 1, 2, R, 1, FTEXCT, IERR)
      CALL NOT(IERR, FTEARG - 6, ' ')
      CALL FTBNUL(IP, 2, 1, 2, R, 2, 9, IERR)
      CALL NOT(IERR, FTEARG - 7, ' ')
      CALL FTBXYZ(IP, 2, 1, 100000000, IBOD, IBOD, R, 1, IERR)
      CALL NOT(IERR, FTEARG - 4, 'n is 100000000')
      CALL FTBXYZ(IP, 2, 4, 2, IBOD, IBOD, R, 4, IERR)
      CALL NOT(IERR, FTEARG - 3, ' ')
      CALL FTBXYF(IP, 2, 3, IERR)
      CALL NOT(IERR, FTEARG - 3, 'FETI_SOFT')
      CALL FTBLOD(IP, 2, 3, R, IERR)
      CALL NOT(IERR, FTEARG - 3, ' ')
      CALL FTBFIX(IP, 2, -1, IS, IERR)
      CALL NOT(IERR, FTEARG - 3, ' ')
C     Rows: with bodies and without the positions differ.
      CALL FTROWS(IP, 9, 1, IPTR, IBOD, ICOL, A, C, N, IERR)
      CALL NOT(IERR, FTEARG - 2, 'EQUALITY')
      IBOD(1) = 4
      CALL FTROWS(IP, FTKINE, 1, IPTR, IBOD, ICOL, A, C, N, IERR)
      CALL NOT(IERR, FTEARG - 5, 'row 1')
      IBOD(1) = 2
      ICOL(1) = 6
      CALL FTROWS(IP, FTKINE, 1, IPTR, IBOD, ICOL, A, C, N, IERR)
      CALL NOT(IERR, FTEARG - 6, 'row 1')
      CALL FTROWC(IP, FTKINE, 1, IPTR, ICOL, A, C, N, IERR)
      CALL NOT(IERR, FTEARG - 5, 'row 1')
      ICOL(1) = 1
      C(1) = 1D300
      C(1) = -C(1) * C(1)
      CALL FTROWS(IP, FTKINE, 1, IPTR, IBOD, ICOL, A, C, N, IERR)
      CALL NOT(IERR, FTEARG - 8, ' ')
      CALL FTROWC(IP, FTKINE, 1, IPTR, ICOL, A, C, N, IERR)
      CALL NOT(IERR, FTEARG - 7, ' ')
      C(1) = 0D0
      CALL FTRRHS(IP, FTKINE, 0, 1, C, IERR)
      CALL NOT(IERR, FTEARG - 3, ' ')
C     Options, answers.
      CALL FTSETD(IP, 'no such option', 1D0, IERR)
      CALL NOT(IERR, FTEARG - 2, 'no such option')
      CALL FTSETI(IP, 'threads', -1, IERR)
      CALL NOT(IERR, FTEARG - 3, 'threads')
      CALL FTGETD(IP, 'threads', D, IERR)
      CALL NOT(IERR, FTEARG - 2, 'threads')
      CALL FTOPTA(0, TEXT, TEXT, N, D, D, D, N, TEXT, IERR)
      CALL NOT(IERR, FTEARG - 1, ' ')
      CALL FTDISP(IP, 2, 2, R, IERR)
      CALL NOT(IERR, FTESTA, ' ')
C     The text is cut where there is no room; blank after a success.
      CALL FTERR(IERR, TEXT(1:5))
      CALL HOLDS(TEXT(1:5) .NE. ' ', 'a text that is cut')
      CALL FTPERR(IP, TEXT(1:5), L, IERR)
      CALL OK(IERR, 'FTPERR')
      CALL HOLDS(L .GT. 5, 'length of a text that is cut')
      CALL FTERR(IERR, TEXT)
      CALL HOLDS(TEXT .EQ. ' ', 'text of a success')
      CALL SOLVES(IP, 10D0, -0.3D0, 'a problem after refused calls')
      CALL FTACTV(IP, 3, IS, IERR)
      CALL NOT(IERR, FTEARG - 2, ' ')
      CALL FTMULT(IP, 0, 2, R, IERR)
      CALL NOT(IERR, FTEARG - 2, ' ')
      CALL FTSRES(IP, 1, IERR)
      CALL NOT(IERR, FTEARG - 2, ' ')
      CALL FTFREE(IP, IERR)
      CALL OK(IERR, 'FTFREE')
      END

C     The status is the one that is due, and its text has the word.
      SUBROUTINE NOT(IERR, IDUE, WORD)
      INTEGER IERR, IDUE
      CHARACTER WORD*(*), TEXT*300, GOT*12
      WRITE (GOT, '(I12)') IERR
      CALL FTERR(IERR, TEXT)
      CALL HOLDS(IERR .EQ. IDUE, 'status'//GOT//': '//TEXT)
      CALL HOLDS(TEXT .NE. ' ' .AND. INDEX(TEXT, WORD) .GT. 0, TEXT)
      END
